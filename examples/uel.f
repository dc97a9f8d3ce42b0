C     The rocking wall as a user element with the argument list of
C     Abaqus' UEL. One node, one degree of freedom: the displacement of
C     the link relative to the ground.
C
C     PROPS  1 half height h [m]        2 half width b [m]
C            3 mass [kg]                4 eta_0   5 eta_alpha
C            6 velocity factor e        7, 8 stiffness [N/m] and
C              damping [N s/m] that hold the resting wall
C     ADLMAG(1,1)  ground acceleration at the end of the increment
C     SVARS  1 side (0 rest, 1, -1)     2 impacts so far
C            3 factor that the host applies to the velocity of the node
C              after this increment (1: none; an element cannot do it)
C            4 mass of the host at the node [kg], set by the host
C
C     LFLAGS(3) = 1: residual and tangent for the increment
C                 6: residual and mass, for initial accelerations
C     PNEWDT < 1 asks for a shorter increment that ends at the impact.
      subroutine uel(rhs, amatrx, svars, energy, ndofel, nrhs, nsvars,
     &   props, nprops, coords, mcrd, nnode, u, du, v, a, jtype, time,
     &   dtime, kstep, kinc, jelem, params, ndload, jdltyp, adlmag,
     &   predef, npredf, lflags, mlvarx, ddlmag, mdload, pnewdt, jprops,
     &   njprop, period)
      use rwmf, only: element_response_t, error_t, uplift_demand_of,
     &   next_impact, respond, settles, velocity_factor,
     &   wall_element_t
      implicit none
      integer ndofel, nrhs, nsvars, nprops, mcrd, nnode, jtype, kstep,
     &   kinc, jelem, ndload, npredf, mlvarx, mdload, njprop
      integer jdltyp(mdload,*), lflags(*), jprops(*)
      double precision rhs(mlvarx,*), amatrx(ndofel,ndofel), svars(*),
     &   energy(8), props(*), coords(mcrd,nnode), u(ndofel),
     &   du(mlvarx,*), v(ndofel), a(ndofel), time(2), dtime, params(*),
     &   adlmag(mdload,*), predef(2,npredf,nnode), ddlmag(mdload,*),
     &   pnewdt, period
      integer side, i, ierr
      logical hit
      double precision tau, u0, v0, ag, push
      type(wall_element_t) elem
      type(element_response_t) resp
      type(error_t), allocatable :: error

      call mkelem(props, elem, ierr)
      if (ierr .ne. 0) then
         pnewdt = 0.25d0
         return
      end if
      ag = adlmag(1,1)
      side = nint(svars(1))
      svars(3) = 1d0

      if (side .eq. 0) then
         push = props(7)*u(1) + props(8)*v(1)
         rhs(1,1) = -push
         amatrx(1,1) = 0d0
         if (lflags(3) .eq. 1) amatrx(1,1) = props(7)
     &      + 2d0/dtime*props(8)
         do 10 i = -1, 1, 2
            if (uplift_demand_of(elem, i, push, ag) .gt. 0d0)
     &         svars(1) = i
   10    continue
         return
      end if

      call respond(elem, side, u(1), v(1), a(1), ag, resp, error)
      if (allocated(error)) then
         pnewdt = 0.25d0
         return
      end if
      rhs(1,1) = -resp%force
      amatrx(1,1) = resp%mass
      if (lflags(3) .ne. 1) return
C     average acceleration (PARAMS: alpha = 0, beta = 1/4, gamma = 1/2)
      amatrx(1,1) = resp%mass/(params(2)*dtime**2)
     &   + params(3)/(params(2)*dtime)*resp%damping + resp%stiffness

C     state at the beginning of the increment, from average acceleration
      u0 = u(1) - du(1,1)
      v0 = 2d0*du(1,1)/dtime - v(1)
      call next_impact(side, dtime, u0, v0, u(1), v(1), hit, tau)
      if (.not. hit) return
      if (dtime - tau .gt. 1d-9*dtime .and. tau .gt. 1d-9) then
         pnewdt = tau/dtime
         return
      end if
      svars(1) = -side
      svars(2) = svars(2) + 1d0
      svars(3) = velocity_factor(elem)
      if (settles(elem, period, svars(3)*v(1), 0d0, ag, svars(4))) then
         svars(1) = 0d0
         svars(3) = 0d0
      end if
      end

C     Element from its properties; IERR is not 0 when they are bad.
      subroutine mkelem(props, elem, ierr)
      use rwmf, only: case_t, create_element, error_t, read_case_text,
     &   wall_element_t
      implicit none
      double precision props(*)
      integer ierr
      type(wall_element_t) elem
      type(error_t), allocatable :: error
      type(case_t) cas
      character(500) text
      character nl
      nl = new_line('a')
      write (text, 100) props(1), props(2), props(3), nl, props(4),
     &   props(5), nl, props(6), nl, nl
  100 format ('&wall h=', es24.16, ', b=', es24.16, ', m_w=', es24.16,
     &   ' /', a, '&cable eta_0=', es24.16, ', eta_alpha=', es24.16,
     &   ' /', a, '&impact rule="constant", e=', es24.16, ' /', a,
     &   '&model formulation="exact" /', a, '&solver t_end=1.0 /')
      call read_case_text(text, '', cas, error)
      if (.not. allocated(error)) then
         call create_element(elem, cas, error)
      end if
      ierr = 0
      if (allocated(error)) ierr = error%stat
      end
