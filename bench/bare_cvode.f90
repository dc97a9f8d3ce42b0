!> Lower bound of the cost of CVODE, measured for one El Centro ordinate.
!> A hand-written loop with the kernel's stops, events and restarts runs beside the kernel itself.
!>
!> Usage: bare_cvode CASE.nml  (symmetric wall with frame and linear cable under a record)
!>
!> Prints the least time of many alternating repeats and the ratio, which is the kernel's overhead.
program bare_cvode
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_funloc, c_int, c_loc, &
      c_null_ptr, c_ptr
   use fcvode_mod, only: CV_ADAMS, CV_ONE_STEP, CV_ROOT_RETURN, FCVode, FCVodeCreate, FCVodeFree, &
      FCVodeGetRootInfo, FCVodeInit, FCVodeReInit, FCVodeRootInit, FCVodeSetNonlinearSolver, &
      FCVodeSetStopTime, FCVodeSetUserData, FCVodeSVtolerances
   use fnvector_serial_mod, only: FN_VMake_Serial
   use fsundials_context_mod, only: FSUNContext_Create, FSUNContext_Free
   use fsundials_nonlinearsolver_mod, only: FSUNNonlinSolFree, SUNNonlinearSolver
   use fsundials_nvector_mod, only: FN_VDestroy, FN_VGetArrayPointer, N_Vector
   use fsunnonlinsol_fixedpoint_mod, only: FSUNNonlinSol_FixedPoint
   use rwmf, only: case_t, error_t, i8, read_case_file, result_t, simulate, wp
   use rwmf_core_kinds, only: pi
   implicit none

   integer, parameter :: repeats = 40

   !> Data of the callbacks.
   type :: scene_t
      real(wp) :: alpha, R, g, gamma, omega, xi, eta_0, slope_eta, e
      real(wp) :: t_k, a_k, slope
      !! segment of the record in force
      integer :: side
   end type scene_t

   type(case_t) :: case
   type(error_t), allocatable :: error
   type(result_t) :: result
   character(4096) :: path
   real(wp) :: bare
   real(wp) :: equal
   real(wp) :: kernel
   real(wp) :: u_bare
   real(wp) :: u_equal
   integer(i8) :: steps
   integer(i8) :: steps_equal
   integer :: i

   call get_command_argument(1, path)
   call read_case_file(trim(path), case, error)
   if (allocated(error)) then
      print '(a)', error%message
      stop 2
   end if
   ! the right-hand side of this program takes accelerations in m/s2
   if (allocated(case%record)) case%record%a = case%record%factor*case%record%a
   bare = huge(bare)
   equal = huge(equal)
   kernel = huge(kernel)
   do i = 1, repeats
      bare = min(bare, seconds_of_bare_loop(case%solver%rtol, u_bare, steps))
      ! The kernel gives CVODE a quarter of the tolerance (integrator/sundials/cvode.f90).
      equal = min(equal, seconds_of_bare_loop(0.25_wp*case%solver%rtol, u_equal, steps_equal))
      call simulate(case, result, error)
      if (allocated(error)) stop 1
      kernel = min(kernel, result%seconds)
   end do
   print '(a)', 'loop                               ms     steps   u_s_max (m)'
   print '(a, f10.3, i10, es22.12)', 'bare, rtol of the case    ', 1000*bare, steps, u_bare
   print '(a, f10.3, i10, es22.12)', 'bare, the kernel''s share  ', 1000*equal, steps_equal, u_equal
   print '(a, f10.3, i10, es22.12)', 'kernel, method adams      ', 1000*kernel, result%steps, &
      result%u_s_max
   print '(a, f6.3)', 'kernel over bare, rtol of the case:       ', kernel/bare
   print '(a, f6.3)', 'kernel over bare, tolerances passed alike:', kernel/equal

contains

   !> Run the loop once and return the wall-clock time [s].
   real(wp) function seconds_of_bare_loop(rtol, u_max, n_steps) result(seconds)
      real(wp), intent(in) :: rtol
      real(wp), intent(out) :: u_max
      integer(i8), intent(out) :: n_steps
      type(scene_t), target :: scene
      type(c_ptr) :: context, memory
      type(N_Vector), pointer :: vector, tolerances
      type(SUNNonlinearSolver), pointer :: iteration
      real(wp), target :: y(2)
      real(wp), target :: atol(2)
      real(wp) :: t(1)
      integer(i8) :: begin, finish, rate
      integer(c_int) :: flag
      integer :: k
      logical :: is_new

      call system_clock(begin, rate)
      flag = FSUNContext_Create(c_null_ptr, context)
      call fill(scene)
      ! The wall rests until the sample interval in which the motion causes uplift.
      call first_lift_off(scene, t(1), k)
      y = 0
      atol = rtol*[1.0e-3_wp, 1.0e-3_wp*scene%omega]
      vector => FN_VMake_Serial(2_i8, y, context)
      tolerances => FN_VMake_Serial(2_i8, atol, context)
      memory = FCVodeCreate(CV_ADAMS, context)
      flag = FCVodeInit(memory, c_funloc(rhs), t(1), vector)
      flag = FCVodeSetUserData(memory, c_loc(scene))
      flag = FCVodeSVtolerances(memory, rtol, tolerances)
      iteration => FSUNNonlinSol_FixedPoint(vector, 0_c_int, context)
      flag = FCVodeSetNonlinearSolver(memory, iteration)
      flag = FCVodeRootInit(memory, 2_c_int, c_funloc(roots))
      u_max = 0
      n_steps = 0
      is_new = .true.
      do while (k < case%record%n)
         call enter(scene, k)
         do while (t(1) < case%record%t(k + 1))
            if (.not. is_new) then
               continue
            else
               flag = FCVodeReInit(memory, t(1), vector)
               is_new = .false.
            end if
            flag = FCVodeSetStopTime(memory, case%record%t(k + 1))
            flag = FCVode(memory, case%record%t(k + 1), vector, t, CV_ONE_STEP)
            if (flag < 0) exit
            n_steps = n_steps + 1_i8
            if (flag == CV_ROOT_RETURN) call handle_roots(memory, scene, y, u_max, is_new)
         end do
         k = k + 1
      end do
      call FCVodeFree(memory)
      flag = FSUNNonlinSolFree(iteration)
      call FN_VDestroy(vector)
      call FN_VDestroy(tolerances)
      flag = FSUNContext_Free(context)
      call system_clock(finish)
      seconds = real(finish - begin, wp)/real(rate, wp)
   end function seconds_of_bare_loop

   subroutine fill(scene)
      type(scene_t), intent(out) :: scene

      scene%alpha = atan2(case%wall%b, case%wall%h)
      scene%R = hypot(case%wall%b, case%wall%h)
      scene%g = case%model%g
      scene%gamma = case%frame%gamma
      scene%omega = 2*pi/case%frame%T_s
      scene%xi = case%frame%xi_s
      scene%eta_0 = case%cable%eta_0
      scene%slope_eta = (case%cable%eta_alpha - case%cable%eta_0)/scene%alpha
      scene%e = case%impact%e
   end subroutine fill

   !> First instant at which |u_g''| exceeds the threshold, by linear interpolation.
   subroutine first_lift_off(scene, t, k)
      type(scene_t), intent(inout) :: scene
      real(wp), intent(out) :: t
      integer, intent(out) :: k
      real(wp) :: threshold
      real(wp) :: a

      threshold = scene%g*tan(scene%alpha)*(1 + scene%eta_0)/(1 + 2*scene%gamma)
      k = 1
      do while (abs(case%record%a(k + 1)) <= threshold)
         k = k + 1
      end do
      call enter(scene, k)
      a = sign(threshold, case%record%a(k + 1))
      t = scene%t_k + (a - scene%a_k)/scene%slope
      scene%side = -nint(sign(1.0_wp, a))
   end subroutine first_lift_off

   subroutine enter(scene, k)
      type(scene_t), intent(inout) :: scene
      integer, intent(in) :: k

      scene%t_k = case%record%t(k)
      scene%a_k = case%record%a(k)
      scene%slope = (case%record%a(k + 1) - case%record%a(k)) &
         /(case%record%t(k + 1) - case%record%t(k))
   end subroutine enter

   !> Handle a root. Peak: record it. Impact: set theta = 0, reduce the velocity, restart.
   subroutine handle_roots(memory, scene, y, u_max, is_new)
      type(c_ptr), intent(in) :: memory
      type(scene_t), intent(inout) :: scene
      real(wp), intent(inout) :: y(2)
      real(wp), intent(inout) :: u_max
      logical, intent(inout) :: is_new
      integer(c_int) :: which(2)
      integer(c_int) :: flag

      flag = FCVodeGetRootInfo(memory, which)
      if (which(2) /= 0) then
         u_max = max(u_max, 2*scene%R*abs(sin(scene%alpha) - sin(scene%alpha - abs(y(1)))))
      end if
      if (which(1) /= 0 .and. scene%side*y(2) < 0) then
         y = [0.0_wp, scene%e*y(2)]
         scene%side = -scene%side
         is_new = .true.
      end if
   end subroutine handle_roots

   !> Eq. (8) and its mirror image in a direct implementation.
   integer(c_int) function rhs(t, vector, vector_dot, user_data) bind(c)
      real(c_double), value :: t
      type(N_Vector), intent(inout) :: vector, vector_dot
      type(c_ptr), value :: user_data
      type(scene_t), pointer :: p
      real(c_double), pointer :: y(:), first(:), y_dot(:)
      real(wp) :: phi, phi_dot, s, c, f

      call c_f_pointer(user_data, p)
      first => FN_VGetArrayPointer(vector)
      call c_f_pointer(c_loc(first(1)), y, [2])
      first => FN_VGetArrayPointer(vector_dot)
      call c_f_pointer(c_loc(first(1)), y_dot, [2])
      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      f = p%side*(p%a_k + p%slope*(t - p%t_k))
      y_dot(1) = y(2)
      y_dot(2) = p%side*(-4*p%gamma*c*(s*phi_dot**2 + 2*p%omega*p%xi*c*phi_dot &
         + p%omega**2*(sin(p%alpha) - s)) - (2*p%gamma + 1)/p%R*c*f &
         - p%g/p%R*(s + (p%eta_0 + p%slope_eta*phi)*sin(p%alpha)))/(4.0_wp/3 + 4*p%gamma*c**2)
      rhs = 0
   end function rhs

   !> theta and theta' as root functions.
   integer(c_int) function roots(t, vector, g, user_data) bind(c)
      real(c_double), value :: t
      type(N_Vector), intent(inout) :: vector
      real(c_double), intent(out) :: g(2)
      type(c_ptr), value :: user_data
      real(c_double), pointer :: first(:), y(:)

      first => FN_VGetArrayPointer(vector)
      call c_f_pointer(c_loc(first(1)), y, [2])
      g = y
      roots = 0
   end function roots

end program bare_cvode
