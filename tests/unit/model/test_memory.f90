!> Springs with memory, one by one along random paths and as part of a scene.
program test_memory
   use check, only: checks_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_bilinear_spring, only: is_broken
   use rwmf_model_hysteresis_spring_laws, only: new_spring, pass_limit, spring_energy, &
      spring_force, spring_limits, spring_loss, spring_plastic, turn_spring
   use rwmf_model_spring, only: branch_t, spring_t
   use rwmf_model_system_assembly, only: build_equation, enter_interval, enter_side, equation_t, &
      second_derivative
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t, devices_t
   use scenes, only: rwmf_scene
   implicit none

   real(wp), parameter :: k = 3
   real(wp), parameter :: yield = 0.6_wp
   type(checks_t) :: checks

   call check_way(new_spring(k, yield, 0.0_wp), 0.0_wp, 'elastic, perfectly plastic')
   call check_way(new_spring(k, yield, 0.1_wp), 0.1_wp, 'hardening')
   if (checks%wants('rupture')) call check_rupture()
   if (checks%wants('fuse_moment')) call check_fuse_moment()
   call checks%finish()

contains

   !> Move a spring from the elongation a to b and add its dissipation to the sum.
   subroutine move(spring, branch, a, b, dissipated)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: a
      real(wp), intent(in) :: b
      real(wp), intent(inout) :: dissipated
      real(wp) :: x
      real(wp) :: to
      real(wp) :: limits(2)

      call turn_spring(spring, branch, a)
      dissipated = dissipated - spring_loss(spring, branch, a)
      x = a
      do
         call spring_limits(spring, branch, limits(1), limits(2))
         to = max(limits(1), min(b, limits(2)))
         if (b > a) to = max(x, to)
         if (b < a) to = min(x, to)
         x = to
         if (b > a .and. b > limits(2)) then
            call pass_limit(spring, branch, is_rising=.true.)
         else if (b < a .and. b < limits(1)) then
            call pass_limit(spring, branch, is_rising=.false.)
         else
            exit
         end if
      end do
      dissipated = dissipated + spring_loss(spring, branch, x)
   end subroutine move

   !> Check a path of random turning points. The force follows from a return mapping, an independent
   !> update of the plastic elongation. Work = stored + dissipated.
   subroutine check_way(spring, hardening, name)
      type(spring_t), intent(in) :: spring
      real(wp), intent(in) :: hardening
      character(*), intent(in) :: name
      integer, parameter :: turns = 500
      type(branch_t) :: branch
      real(wp) :: way(turns)
      real(wp) :: x, plastic, modulus, excess, dissipated, work, energy, worst, worst_balance
      integer :: n

      if (.not. checks%wants('way, '//name)) return
      call random_init(repeatable=.true., image_distinct=.true.)
      call random_number(way)
      way = 2*way - 1
      modulus = hardening*k/(1 - hardening)
      x = 0
      plastic = 0
      dissipated = 0
      work = 0
      worst = 0
      worst_balance = 0
      do n = 1, turns
         energy = k*(x - plastic)**2/2 + modulus*plastic**2/2
         call move(spring, branch, x, way(n), dissipated)
         x = way(n)
         ! Return mapping: the elastic trial force, returned to the yield surface.
         excess = k*(x - plastic) - modulus*plastic
         work = work - energy
         if (abs(excess) > yield) then
            work = work + yield*(abs(excess) - yield)/(k + modulus)
            plastic = plastic + sign((abs(excess) - yield)/(k + modulus), excess)
         end if
         work = work + k*(x - plastic)**2/2 + modulus*plastic**2/2
         worst = max(worst, abs(spring_force(spring, branch, x) - k*(x - plastic)), &
            abs(spring_plastic(spring, branch, x) - plastic))
         worst_balance = max(worst_balance, abs(work - spring_energy(spring, branch, x) &
            - dissipated))
      end do
      call checks%close_to(worst, 0.0_wp, 'return mapping, '//name, atol=1.0e-13_wp)
      call checks%close_to(worst_balance, 0.0_wp, 'energy, '//name, atol=1.0e-11_wp)
   end subroutine check_way

   !> Check that a broken tendon carries no force and that its stored energy is dissipated.
   subroutine check_rupture()
      type(spring_t) :: tendon
      type(branch_t) :: branch
      real(wp) :: dissipated

      tendon = new_spring(k, yield, 0.0_wp, 0.4_wp, is_tendon=.true., rupture=0.3_wp)
      dissipated = 0
      call move(tendon, branch, 0.0_wp, 0.29_wp, dissipated)
      call checks%that(.not. is_broken(branch), 'below the strain of rupture')
      call move(tendon, branch, 0.29_wp, 0.31_wp, dissipated)
      call checks%that(is_broken(branch), 'rupture')
      call move(tendon, branch, 0.31_wp, -0.5_wp, dissipated)
      call checks%close_to(spring_force(tendon, branch, -0.5_wp), 0.0_wp, 'broken for good')
      call checks%close_to(dissipated, yield*(0.3_wp - 0.2_wp/k) + yield**2/(2*k), &
         'dissipation up to rupture, and what it held', rtol=1.0e-13_wp)
   end subroutine check_rupture

   !> Compare the moment of a fuse with its definition, on the side whose corner lifts. It is the
   !> force times the derivative of the chord 4b sin(phi/2).
   subroutine check_fuse_moment()
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: with
      type(equation_t) :: without
      real(wp), parameter :: phi = 0.001_wp
      real(wp) :: force
      real(wp) :: mass
      integer :: side

      case = rwmf_scene('symmetric', 5.0_wp, 1.0_wp, 'dop853')
      motion = motion_from_case(case)
      call build_equation(case, motion, without)
      case%fuse = devices_t(eta_y=spread(0.4_wp, 1, 2), stroke_y=spread(0.004_wp, 1, 2), &
         hardening=spread(0.0_wp, 1, 2))
      call build_equation(case, motion, with)
      force = 0.4_wp*case%model%g*4*case%wall%b*sin(phi/2)/0.004_wp
      mass = with%p%R**2*(4.0_wp/3 + 4*with%p%gamma*cos(with%p%alpha - phi)**2)
      do side = -1, 1, 2
         call enter_side(with%model_t, with%state, side)
         call enter_side(without%model_t, without%state, side)
         call enter_interval(with%model_t, with%state, 1)
         call enter_interval(without%model_t, without%state, 1)
         call checks%close_to(second_derivative(with, 20.0_wp, [side*phi, 0.1_wp]) &
            - second_derivative(without, 20.0_wp, [side*phi, 0.1_wp]), &
            -side*force*2*case%wall%b*cos(phi/2)/mass, 'moment of a fuse', rtol=1.0e-10_wp)
      end do
   end subroutine check_fuse_moment

end program test_memory
