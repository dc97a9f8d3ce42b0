C     A small host that drives the user element as Abaqus would: one
C     mass on spring and damper, average acceleration, Newton's
C     iteration, increments that the element may cut with PNEWDT.
C     Fails unless the displacement is that of the kernel.
      program harnes
      use rwmf, only: advance_stepping, case_t, create_stepping,
     &   destroy_stepping, error_t, query_state, read_case_text,
     &   stepping_t, wall_state_t
      implicit none
      integer i, j, lflags(5), jdltyp(1,1), jprops(1), cuts
      double precision rhs(1,1), amatrx(1,1), svars(4), energy(8),
     &   props(8), coords(1,1), u(1), du(1,1), v(1), a(1), time(2),
     &   params(3), adlmag(1,1), predef(2,1,1), ddlmag(1,1), pnewdt
      double precision dt, h, left, m, c, k, om, u0, v0, a0, ag0, ag1,
     &   sv(4), r, err, ground, step
      type(case_t) cas
      type(stepping_t) wall
      type(wall_state_t) state
      type(error_t), allocatable :: error
      character(*), parameter :: nl = new_line('a')
      character(*), parameter :: text =
     &   '&wall h=2.0, b=0.5, m_w=2.0e4 /'//nl//
     &   '&frame T_s=0.8, gamma=5.0, xi_s=0.05 /'//nl//
     &   '&cable eta_0=1.0, eta_alpha=5.0 /'//nl//
     &   '&impact rule="constant", e=0.9 /'//nl//
     &   '&model formulation="exact" /'//nl//
     &   '&solver method="dop853", t_end=1.0 /'
      external ground
      call read_case_text(text, '', cas, error)
      if (.not. allocated(error)) then
         call create_stepping(wall, cas, error)
      end if
      if (allocated(error)) stop 1

      m = 5d0*2.0d4
      om = 2d0*acos(-1d0)/0.8d0
      k = m*om**2
      c = 2d0*0.05d0*om*m
      props = [2d0, 0.5d0, 2.0d4, 1d0, 5d0, 0.9d0, 1d12, 3d8]
      params = [0d0, 0.25d0, 0.5d0]
      svars = [0d0, 0d0, 1d0, m]
      energy = 0d0
      coords = 0d0
      predef = 0d0
      ddlmag = 0d0
      jdltyp = 1
      jprops = 0
      lflags = [11, 0, 1, 0, 0]
      u = 0d0
      v = 0d0
      a = 0d0
      err = 0d0
      step = 0.02d0
      dt = 0.002d0
      do 50 i = 1, nint(3d0/dt)
         ag0 = ground((i - 1)*dt)
         ag1 = ground(i*dt)
         left = dt
         do 40 cuts = 1, 1000
            if (left .le. 1d-12) goto 45
            h = left
            u0 = u(1)
            v0 = v(1)
            a0 = a(1)
   20       continue
            adlmag(1,1) = ag1 - (ag1 - ag0)*(left - h)/dt
            u(1) = u0
            do 30 j = 1, 30
               du(1,1) = u(1) - u0
               a(1) = 4d0/h*(du(1,1)/h - v0) - a0
               v(1) = 2d0/h*du(1,1) - v0
               sv = svars
               pnewdt = 1d0
               time = [(i - 1)*dt, (i - 1)*dt]
               call uel(rhs, amatrx, sv, energy, 1, 1, 4, props, 8,
     &            coords, 1, 1, u, du, v, a, 1, time, h, 1, i, 1,
     &            params, 1, jdltyp, adlmag, predef, 1, lflags, 1,
     &            ddlmag, 1, pnewdt, jprops, 1, dt)
               r = rhs(1,1) - m*(a(1) + adlmag(1,1)) - c*v(1) - k*u(1)
               r = r/(4d0/h**2*m + 2d0/h*c + k + amatrx(1,1))
               if (abs(r) .le. 1d-16 + 1d-13*abs(u(1))) goto 35
               u(1) = u(1) + r
   30       continue
   35       continue
            if (pnewdt .lt. 1d0) then
               h = pnewdt*h
               goto 20
            end if
            left = left - h
            if (nint(sv(1)) .ne. nint(svars(1))) then
C              the side changed: jump of the velocity, new acceleration
               v(1) = sv(3)*v(1)
               a(1) = 0d0
               if (nint(sv(1)) .ne. 0) then
                  lflags(3) = 6
                  svars = sv
                  call uel(rhs, amatrx, sv, energy, 1, 1, 4, props, 8,
     &               coords, 1, 1, u, du, v, a, 1, time, h, 1, i, 1,
     &               params, 1, jdltyp, adlmag, predef, 1, lflags, 1,
     &               ddlmag, 1, pnewdt, jprops, 1, dt)
                  lflags(3) = 1
                  a(1) = (rhs(1,1) - m*adlmag(1,1) - c*v(1) - k*u(1))
     &               /(m + amatrx(1,1))
               end if
            end if
            svars = sv
   40    continue
         stop 2
   45    continue
         if (mod(i, nint(step/dt)) .eq. 0) then
            j = i/nint(step/dt)
            call advance_stepping(wall, [(j - 1)*step, j*step],
     &         [ground((j - 1)*step), ground(j*step)], error)
            if (allocated(error)) stop 3
            call query_state(wall, state, error)
            err = max(err, abs(u(1) - state%u_s))
         end if
   50 continue
      print '(a, es10.3, a, i0, a)', ' difference from the kernel ',
     &   err, ' m after ', nint(svars(2)), ' impacts'
      if (err .gt. 0.01d0*state%u_s_max) stop 4
      call destroy_stepping(wall)
      end

C     Ground acceleration [m/s2]: straight lines, knots at 0.02 s.
      double precision function ground(t)
      implicit none
      double precision t, h, x, n
      h = 0.02d0
      n = aint(t/h + 1d-9)
      x = max(0d0, t/h - n)
      ground = 0d0
      if (n*h .lt. 2.999d0) ground = (1d0 - x)*5d0*sin(7d0*n*h)
      if ((n + 1d0)*h .lt. 2.999d0) then
         ground = ground + x*5d0*sin(7d0*(n + 1d0)*h)
      end if
      end
