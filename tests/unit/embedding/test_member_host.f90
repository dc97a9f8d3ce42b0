!> Host programs that own the frame and integrate it with a member: walls that bend, floors on link
!> springs and rigid links, all devices. The difference from the kernel falls with the square of the
!> step, through impacts, contacts and ends of branches.
program test_member_host
   use check, only: checks_t
   use member_cases, only: member_case, member_case_count, member_case_name
   use rwmf, only: advance_stepping, case_t, commit_member, create_member, create_stepping, &
      destroy_stepping, error_t, event_impact, event_lift_off, land_member, link_motion_t, &
      member_event_t, member_response_t, member_settles, next_member_event, place_member, &
      query_links, query_state, read_case_text, respond_member, stepping_t, wall_member_t, &
      wall_state_t, wp
   use rwmf_model_equation, only: straight_displacement
   use rwmf_problem_shear_frame, only: damping_matrix
   implicit none

   interface
      !> Solve a linear system with one right-hand side (LAPACK).
      subroutine dgesv(n, nrhs, a, lda, pivots, b, ldb, info)
         import :: wp
         implicit none
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, n), b(ldb, nrhs)
         integer, intent(out) :: pivots(n), info
      end subroutine dgesv
   end interface

   !> Frame of the host.
   type :: frame_t
      logical :: is_free
      !! the floors are degrees of freedom on link springs; otherwise the wall moves them
      real(wp), allocatable :: m(:, :)
      !! (floors, floors) [kg]
      real(wp), allocatable :: c(:, :)
      !! [N s/m]
      real(wp), allocatable :: k(:, :)
      !! [N/m]
   end type frame_t

   !> Equations of frame and member at a motion.
   type :: equations_t
      real(wp), allocatable :: rest(:)
      !! (dofs) [N]
      real(wp), allocatable :: k(:, :), c(:, :), m(:, :)
      !! (dofs, dofs) [N/m], [N s/m], [kg]
      real(wp), allocatable :: host_mass(:, :)
      !! (dofs, dofs) masses of the frame alone [kg]
      real(wp) :: push = 0
      !! force of the frame on u [N]
   end type equations_t

   real(wp), parameter :: m_w = 2.0e4_wp, every = 0.02_wp
   type(checks_t) :: checks
   character(20), parameter :: names(7) = [character(20) :: 'fuse', 'every_floor', 'springs', &
      'all, rigid', 'bending', 'bending, every_floor', 'all, bending']
   integer :: i

   do i = 1, member_case_count
      if (all(member_case_name(i) /= names)) cycle
      if (checks%wants('host, '//member_case_name(i))) call test_host(i)
   end do
   call checks%finish()

contains

   !> Halve the step twice and compare the displacement of the wall with the kernel's.
   subroutine test_host(number)
      integer, intent(in) :: number
      type(case_t) :: case
      type(error_t), allocatable :: error
      character(60) :: found
      real(wp) :: difference(3), dt
      integer :: j, impacts

      call read_case_text(member_case(number, ''), '', case, error)
      call checks%no_error(error, 'case')
      dt = 0.0005_wp
      do j = 1, 3
         call compare(case, dt, difference(j), impacts)
         dt = dt/2
      end do
      write (found, '(3es12.3, a, i0, a)') difference, ' m, ', impacts, ' impacts'
      call checks%that(all(difference(2:) < 0.35_wp*difference(:2)) .and. difference(3) &
         < 1.0e-5_wp .and. impacts > 2, 'host of '//member_case_name(number), trim(found))
   end subroutine test_host

   !> Integrate host and kernel side by side.
   subroutine compare(case, dt, difference, impacts)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: dt
      real(wp), intent(out) :: difference
      !! largest one at the samples [m]
      integer, intent(out) :: impacts
      type(wall_member_t) :: wall
      type(stepping_t) :: kernel
      type(wall_state_t) :: state
      type(frame_t) :: frame
      type(error_t), allocatable :: error
      real(wp), allocatable :: x(:, :)
      integer :: j, part

      impacts = 0
      difference = 0
      call create_member(wall, case, error)
      call create_stepping(kernel, case, error, peak=7.0_wp)
      call checks%no_error(error, 'wall')
      call set_frame(case, wall, frame)
      allocate (x(wall%n, 3), source=0.0_wp)
      call accelerate(frame, wall, 0.0_wp, x)
      do j = 1, 60
         do part = 1, nint(every/dt)
            call step(frame, wall, (j - 1)*every + (part - 1)*dt, dt, x, impacts)
         end do
         call advance_stepping(kernel, [j - 1, j]*every, [sample(j - 1), sample(j)], error)
         if (.not. allocated(error)) call query_state(kernel, state, error)
         call checks%no_error(error, 'kernel')
         difference = max(difference, abs(x(1, 1) - straight_displacement( &
            kernel%instance%equation, kernel%instance%equation%state%side, state%theta)))
      end do
      call destroy_stepping(kernel)
   end subroutine compare

   !> Sample of the ground acceleration [m/s2].
   pure real(wp) function sample(j)
      integer, intent(in) :: j

      sample = 7*sin(8*every*j)
   end function sample

   !> Ground acceleration: straight lines between the samples [m/s2].
   pure real(wp) function ground(t)
      real(wp), intent(in) :: t
      integer :: j

      j = floor(t/every + 1.0e-9_wp)
      ground = sample(j) + (t/every - j)*(sample(j + 1) - sample(j))
   end function ground

   !> Set the frame of the host: one mass at the roof, or storeys.
   subroutine set_frame(case, wall, frame)
      type(case_t), intent(in) :: case
      type(wall_member_t), intent(in) :: wall
      type(frame_t), intent(out) :: frame
      real(wp), parameter :: pi = acos(-1.0_wp)
      real(wp) :: omega
      integer :: n, j

      omega = 2*pi/case%frame%T_s
      n = size(wall%share)
      frame%is_free = allocated(wall%k_link)
      allocate (frame%m(n, n), frame%c(n, n), frame%k(n, n), source=0.0_wp)
      if (.not. allocated(case%frame%floors)) then
         frame%m = m_w*case%frame%gamma
         frame%k = frame%m*omega**2
         frame%c = 2*case%frame%xi_s*omega*frame%m
         return
      end if
      associate (storeys => case%frame%floors)
         do j = 1, n
            frame%m(j, j) = m_w*storeys%m(j)
            frame%k(j, j) = m_w*storeys%k(j)
            if (j == n) exit
            frame%k(j, j) = frame%k(j, j) + m_w*storeys%k(j + 1)
            frame%k(j, j + 1) = -m_w*storeys%k(j + 1)
            frame%k(j + 1, j) = -m_w*storeys%k(j + 1)
         end do
         frame%c = m_w*damping_matrix(storeys, case%frame%xi_s)
         ! the kernel damps a straight line in proportion to its stiffness
         if (.not. frame%is_free) frame%c = 2*case%frame%xi_s/omega*frame%k
      end associate
   end subroutine set_frame

   !> Set up the equations at a motion.
   subroutine assemble(frame, wall, t, x, equations)
      type(frame_t), intent(in) :: frame
      type(wall_member_t), intent(inout) :: wall
      real(wp), intent(in) :: t
      real(wp), intent(in) :: x(:, :)
      type(equations_t), intent(out) :: equations
      type(member_response_t) :: response
      type(link_motion_t) :: links
      type(error_t), allocatable :: error
      real(wp) :: floors(size(frame%m, 1), 3)
      real(wp) :: b(size(frame%m, 1), wall%n)
      real(wp) :: force(wall%n)
      integer :: j

      call respond_member(wall, x, [ground(t), 0.0_wp], response, error)
      if (.not. allocated(error)) call query_links(wall, x, links, error)
      call checks%no_error(error, 'response')
      if (allocated(error)) error stop 1
      if (frame%is_free) then
         floors = x(wall%n - size(floors, 1) + 1:, :)
         b = 0
         do j = 1, size(floors, 1)
            b(j, wall%n - size(floors, 1) + j) = 1
         end do
      else
         floors = links%motion
         b = links%derivatives
      end if
      force = matmul(matmul(frame%m, floors(:, 3) + ground(t)) + matmul(frame%c, floors(:, 2)) &
         + matmul(frame%k, floors(:, 1)), b)
      equations%push = -force(1)
      equations%rest = response%force + force
      equations%host_mass = matmul(transpose(b), matmul(frame%m, b))
      equations%m = response%mass + equations%host_mass
      equations%c = response%damping + matmul(transpose(b), matmul(frame%c, b))
      equations%k = response%stiffness + matmul(transpose(b), matmul(frame%k, b))
   end subroutine assemble

   !> Find the accelerations at the end of a step of average acceleration of length h, by Newton's
   !> method; h = 0: those at the present motion.
   subroutine solve(frame, wall, t, h, x, x_end)
      type(frame_t), intent(in) :: frame
      type(wall_member_t), intent(inout) :: wall
      real(wp), intent(in) :: t, h
      real(wp), intent(in) :: x(:, :)
      real(wp), intent(inout) :: x_end(:, :)
      type(equations_t) :: equations
      real(wp) :: change(size(x, 1), 1)
      integer :: pivots(size(x, 1)), info, j, first

      first = merge(2, 1, wall%committed%side == 0)
      if (first == 2) x_end(1, :) = 0
      do j = 1, 100
         x_end(first:, 2) = x(first:, 2) + h/2*(x(first:, 3) + x_end(first:, 3))
         x_end(first:, 1) = x(first:, 1) + h/2*(x(first:, 2) + x_end(first:, 2))
         call assemble(frame, wall, t + h, x_end, equations)
         equations%m = equations%m + h/2*equations%c + h**2/4*equations%k
         if (first == 2) then
            equations%m(1, :) = 0
            equations%m(:, 1) = 0
            equations%m(1, 1) = 1
            equations%rest(1) = 0
         end if
         change(:, 1) = equations%rest
         call dgesv(size(x, 1), 1, equations%m, size(x, 1), pivots, change, size(x, 1), info)
         x_end(:, 3) = x_end(:, 3) - change(:, 1)
         if (maxval(abs(change)) < 1.0e-11_wp*(1 + maxval(abs(x_end(:, 3))))) return
      end do
      call checks%that(.false., 'Newton converges')
      error stop 1
   end subroutine solve

   !> Compute the accelerations at the present motion.
   subroutine accelerate(frame, wall, t, x)
      type(frame_t), intent(in) :: frame
      type(wall_member_t), intent(inout) :: wall
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: x(:, :)
      real(wp) :: begin(size(x, 1), 3)
      type(error_t), allocatable :: error

      begin = x
      call solve(frame, wall, t, 0.0_wp, begin, x)
      call commit_member(wall, error)
   end subroutine accelerate

   !> Advance over one step, whose events cut it into pieces.
   subroutine step(frame, wall, t_begin, dt, x, impacts)
      type(frame_t), intent(in) :: frame
      type(wall_member_t), intent(inout) :: wall
      real(wp), intent(in) :: t_begin, dt
      real(wp), intent(inout) :: x(:, :)
      integer, intent(inout) :: impacts
      type(member_event_t) :: event
      type(equations_t) :: ends(2)
      type(error_t), allocatable :: error
      real(wp) :: x_end(size(x, 1), 3), motions(size(x, 1), 3, 2), t, h
      integer :: j

      t = t_begin
      do while (t_begin + dt - t > 1.0e-12_wp)
         h = t_begin + dt - t
         x_end = x
         do j = 1, 30
            call solve(frame, wall, t, h, x, x_end)
            if (j == 1) then
               call assemble(frame, wall, t, x, ends(1))
               call assemble(frame, wall, t + h, x_end, ends(2))
               motions(:, :, 1) = x
               motions(:, :, 2) = x_end
               call next_member_event(wall, h, motions, reshape([ground(t), 0.0_wp, ground(t + h), &
                  0.0_wp], [2, 2]), ends%push, event, error, has_branches=.true.)
               call checks%no_error(error, 'event')
               if (event%kind == 0) exit
               h = event%tau
            else if (event%kind /= event_impact .or. abs(x_end(1, 1)) < 1.0e-12_wp) then
               exit
            else
               h = h - x_end(1, 1)/x_end(1, 2)
            end if
         end do
         call commit_member(wall, error)
         t = t + h
         x = x_end
         if (event%kind == event_impact) then
            impacts = impacts + 1
            x(1, 1) = 0
            call land_member(wall, x(:, 1), x(:, 2), error, ends(2)%host_mass)
            call checks%no_error(error, 'landing')
            call accelerate(frame, wall, t, x)
            call settle(frame, wall, t, dt, x)
         else if (event%kind == event_lift_off) then
            call place_member(wall, event%side, error)
         end if
         if (event%kind /= 0) call accelerate(frame, wall, t, x)
      end do
   end subroutine step

   !> Put the wall to rest if its impacts are below the step.
   subroutine settle(frame, wall, t, dt, x)
      type(frame_t), intent(in) :: frame
      type(wall_member_t), intent(inout) :: wall
      real(wp), intent(in) :: t, dt
      real(wp), intent(inout) :: x(:, :)
      type(equations_t) :: equations
      type(error_t), allocatable :: error

      if (wall%committed%side == 0) return
      call assemble(frame, wall, t, x, equations)
      if (.not. member_settles(wall, dt, x, [ground(t), 0.0_wp], equations%push, error, &
         equations%host_mass)) return
      call place_member(wall, 0, error)
      x(1, :) = 0
   end subroutine settle

end program test_member_host
